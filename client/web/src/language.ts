// language: the first script of the page. It loads the page in the language that the user has chosen in the panel View,
// or else in the first language of the browser in which the page exists.
import {show_icon} from "./widgets/icon";
import {of_browser} from "./world/storage";

const folders: {readonly [language: string]: string} = {
  en: "./",
  de: "./de/"
};

function chosen_language(): string {
  const wanted = [of_browser.get("language"), ...navigator.languages].map((name) => name.slice(0, 2).toLowerCase());
  return wanted.find((name) => folders[name] !== undefined) ?? "en";
}

show_icon(); // before the page has loaded, or else the browser asks the server for an icon
const language = chosen_language(), folder = folders[language]!;
document.documentElement.lang = language;
const preload = document.createElement("link");
preload.rel = "modulepreload";
preload.href = `${folder}shared.js`;
document.head.append(preload);
void import(`${folder}page.js`);
