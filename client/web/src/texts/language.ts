// The language of the texts in this folder.
export const language = {
  folder: "", // of the files of the page in this language
  times: "en-GB", // the format of times of the day
};
