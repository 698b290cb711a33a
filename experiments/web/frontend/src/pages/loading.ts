/** The page shown while the images are loaded. */

import { element, showPage } from "../dom";
import { message } from "../messages";

/** How the loading goes on. */
interface Loading {
  moved(loaded: number, total: number): void;
  failed(): void;
}

/** Show an empty progress bar. */
export function showLoading(root: HTMLElement): Loading {
  const bar = element("progress", { max: "1", value: "0" });
  const count = element("p", { class: "hint" });
  const trouble = element("p", { class: "hint", role: "status" });
  showPage(root, message("loading.title"), bar, count, trouble);
  return {
    moved(loaded, total) {
      bar.value = total === 0 ? 1 : loaded / total;
      count.textContent = message("loading.progress", { loaded, total });
      trouble.textContent = "";
    },
    failed() {
      trouble.textContent = message("loading.trouble");
    },
  };
}
