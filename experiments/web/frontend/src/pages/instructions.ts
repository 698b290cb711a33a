/** The instructions, with an example whose odd object is outlined. */

import type { Study } from "../api";
import { element, pressed, showPage } from "../dom";
import { message } from "../messages";
import { Stage, type Stimulus } from "../stage";

/** Show the instructions; resolves when the participant begins. */
export async function showInstructions(
  root: HTMLElement,
  study: Study,
  example: Stimulus | null,
  practice: boolean,
): Promise<void> {
  const label = message(practice ? "instructions.begin_practice" : "instructions.begin");
  const begin = element("button", { class: "primary", type: "button" }, label);
  const stage = example === null ? null : new Stage(example, study.choices);
  const answer = study.example?.answer ?? 0;
  const figure =
    stage === null
      ? []
      : [
          element(
            "figure",
            {},
            stage.area,
            element("figcaption", {}, message("instructions.example", { answer })),
          ),
        ];
  showPage(
    root,
    message("instructions.title"),
    ...study.instructions.map((text) => element("p", {}, text)),
    element("p", { class: "asked" }, study.question),
    ...figure,
    begin,
  );
  if (stage !== null && example !== null) {
    stage.area.style.aspectRatio = `${example.regions.width_px} / ${example.regions.height_px}`;
    stage.area.style.maxWidth = `${example.regions.width_px}px`;
    stage.place();
    stage.outline(answer);
  }
  await pressed(begin);
  stage?.dispose();
}
