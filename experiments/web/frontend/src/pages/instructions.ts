/** The instructions, with an example whose right objects are outlined. */

import type { AnswerValue, Study } from "../api";
import { element, pressed, showPage } from "../dom";
import { message } from "../messages";
import { Stage } from "../stage";
import type { Stimulus } from "../stimulus";

/** The example as it is shown: a decoded stimulus and its right answer. */
export interface Example {
  stimulus: Stimulus;
  answer: AnswerValue;
}

/**
 * Show the instructions; resolves when the participant begins.
 *
 * @param practice - Whether practice trials come first.
 */
export async function showInstructions(
  root: HTMLElement,
  study: Study,
  example: Example | null,
  practice: boolean,
): Promise<void> {
  const label = message(practice ? "instructions.begin_practice" : "instructions.begin");
  const begin = element("button", { class: "primary", type: "button" }, label);
  const figure = example === null ? null : new ExampleFigure(example, study.choices ?? 0);
  showPage(
    root,
    message("instructions.title"),
    ...study.instructions.map((text) => element("p", {}, text)),
    element("p", { class: "asked" }, study.question),
    ...(figure === null ? [] : [figure.view]),
    begin,
  );
  figure?.show();
  await pressed(begin);
  figure?.dispose();
}

/** The example with its outline and caption. */
class ExampleFigure {
  readonly view: HTMLElement;
  private readonly stage: Stage;

  constructor(
    private readonly example: Example,
    choices: number,
  ) {
    const { width_px, height_px } = example.stimulus;
    const labels = [example.answer].flat();
    const key = labels.length > 1 ? "instructions.example_several" : "instructions.example";
    const caption = message(key, { answer: labels.join(", ") });
    this.stage = new Stage(example.stimulus, choices);
    this.stage.area.style.aspectRatio = `${width_px} / ${height_px}`;
    this.stage.area.style.maxWidth = `${width_px}px`;
    this.view = element("figure", {}, this.stage.area, element("figcaption", {}, caption));
  }

  /** Put the picture in its place; call it once the figure is on the page. */
  show(): void {
    this.stage.place();
    this.stage.mark(this.example.answer);
  }

  dispose(): void {
    this.stage.dispose();
  }
}
