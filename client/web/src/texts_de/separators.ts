// The separators in numbers.
import type * as english from "../texts/separators";

export const separators: typeof english.separators = {
  thousands: ".",
  decimal: ",",
};
