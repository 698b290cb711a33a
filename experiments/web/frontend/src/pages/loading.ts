/** The page shown while the images are loaded. */

import { element, showPage } from "../dom";
import { message } from "../messages";

/** Show an empty progress bar; the function returned moves it. */
export function showLoading(root: HTMLElement): (loaded: number, total: number) => void {
  const bar = element("progress", { max: "1", value: "0" });
  const count = element("p", { class: "hint" });
  showPage(root, message("loading.title"), bar, count);
  return (loaded, total) => {
    bar.value = total === 0 ? 1 : loaded / total;
    count.textContent = message("loading.progress", { loaded, total });
  };
}
