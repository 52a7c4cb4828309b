// dom: builds elements. Text reaches the page only as text nodes, so names from other users cannot become markup.

type Child = Node|string|null|undefined|false;
type Attributes = {
  [name: string]: string|number|boolean|null|undefined|((event: never) => void)
};

/** Creates an element. Functions become listeners ("onclick"), true an empty attribute, false and null none. */
export function h<Tag extends keyof HTMLElementTagNameMap>(
  tag: Tag, attributes: Attributes = {}, ...children: Child[]): HTMLElementTagNameMap[Tag] {
  return fill(document.createElement(tag), attributes, children);
}

/** Creates an element of SVG. */
export function svg<Tag extends keyof SVGElementTagNameMap>(
  tag: Tag, attributes: Attributes = {}, ...children: Child[]): SVGElementTagNameMap[Tag] {
  return fill(document.createElementNS("http://www.w3.org/2000/svg", tag), attributes, children);
}

function fill<Made extends Element>(element: Made, attributes: Attributes, children: Child[]): Made {
  for (const [name, value] of Object.entries(attributes)) {
    if (typeof value === "function") {
      element.addEventListener(name.replace(/^on/, ""), value as (event: Event) => void);
    } else if (value !== false && value !== null && value !== undefined) {
      element.setAttribute(name, value === true ? "" : String(value));
    }
  }
  element.append(
    ...children.filter((child): child is Node|string => child !== null && child !== undefined && child !== false));
  return element;
}

/** Sets the text only if it differs, so that selections and screen readers are not disturbed. */
export function set_text(element: Element, text: string): void {
  if (element.textContent !== text) {
    element.textContent = text;
  }
}
