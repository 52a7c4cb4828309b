// The separators in numbers.
export const separators = {
  thousands: ",",
  decimal: ".",
};
