/** Making elements. Texts go in as text nodes, never as HTML. */

type Attributes = Record<string, string | boolean>;

/**
 * Make an element with attributes and children.
 *
 * @param attributes - Set as they are; `true` sets an empty attribute and `false` leaves it out.
 * @param children - Elements, or strings that become text nodes.
 *
 * @example element("p", { class: "note" }, "Thank you")
 */
export function element<K extends keyof HTMLElementTagNameMap>(
  name: K,
  attributes: Attributes = {},
  ...children: (Node | string)[]
): HTMLElementTagNameMap[K] {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (value !== false) {
      made.setAttribute(key, value === true ? "" : value);
    }
  }
  made.append(...children);
  return made;
}

/** Resolve when a button is pressed for the first time. */
export function pressed(button: HTMLButtonElement): Promise<void> {
  return new Promise((resolve) =>
    button.addEventListener("click", () => resolve(), { once: true }),
  );
}

/**
 * Show one page in place of what was there, and move the focus to its heading so that screen
 * readers begin there.
 */
export function showPage(root: HTMLElement, title: string, ...content: Node[]): HTMLElement {
  const heading = element("h1", { tabindex: "-1" }, title);
  const page = element("main", { class: "page" }, heading, ...content);
  root.replaceChildren(page);
  window.scrollTo(0, 0);
  heading.focus();
  return page;
}
