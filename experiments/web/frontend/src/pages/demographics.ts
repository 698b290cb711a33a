/** The page that asks what the study wants to know of a participant. */

import type { Demographics, DemographicsField, Gender } from "../api";
import { element, showPage } from "../dom";
import { type MessageKey, message } from "../messages";

const YOUNGEST = 1;
const OLDEST = 120;
const GENDERS: Gender[] = ["female", "male", "other", "undisclosed"];

/** A question on the page: its elements, and its answer once it has a valid one. */
interface Question {
  view: HTMLElement;
  /** Return the answer, or null after marking what is wrong. */
  read(): Demographics | null;
}

/** Ask the study's questions; resolves with the answers when all are valid. */
export function askDemographics(
  root: HTMLElement,
  fields: DemographicsField[],
): Promise<Demographics> {
  const questions = fields.map((field) => QUESTIONS[field]());
  const go = element("button", { class: "primary" }, message("demographics.continue"));
  // Our own messages appear beside the question; the browser's would not be in the study's language.
  const form = element("form", { novalidate: true }, ...questions.map(({ view }) => view), go);
  showPage(root, message("demographics.title"), form);
  // A message goes when its question is touched again.
  form.addEventListener("input", ({ target }) => {
    const question = (target as Element).closest(".question");
    question?.querySelector(".fault")?.replaceChildren();
    for (const marked of question?.querySelectorAll("[aria-invalid]") ?? []) {
      marked.removeAttribute("aria-invalid");
    }
  });
  return new Promise((resolve) => {
    form.addEventListener("submit", (event) => {
      event.preventDefault();
      const answers = questions.map((question) => question.read());
      if (answers.every((answer) => answer !== null)) {
        resolve(Object.assign({}, ...answers));
      } else {
        form.querySelector<HTMLElement>("[aria-invalid=true]")?.focus();
      }
    });
  });
}

const QUESTIONS: Record<DemographicsField, () => Question> = {
  age: askAge,
  gender: () =>
    askChoice(
      "gender",
      GENDERS.map((gender) => ({ value: gender, label: `demographics.gender.${gender}` })),
      (value) => ({ gender: value as Gender }),
    ),
  artistic_background: () =>
    askChoice(
      "artistic_background",
      (["yes", "no"] as const).map((value) => ({
        value,
        label: `demographics.artistic_background.${value}`,
      })),
      (value) => ({ artistic_background: value === "yes" }),
    ),
};

function askAge(): Question {
  const input = element("input", {
    id: "age",
    inputmode: "numeric",
    autocomplete: "off",
    maxlength: "3",
    "aria-describedby": "age-fault",
  });
  const fault = element("p", { class: "fault", id: "age-fault", role: "alert" });
  const label = element("label", { for: "age" }, message("demographics.age"));
  return {
    view: element("div", { class: "question" }, label, input, fault),
    read() {
      const text = input.value.trim();
      const age = Number(text);
      const valid = /^\d+$/.test(text) && age >= YOUNGEST && age <= OLDEST;
      const limits = { youngest: YOUNGEST, oldest: OLDEST };
      fault.textContent = valid ? "" : message("demographics.age.fault", limits);
      input.setAttribute("aria-invalid", String(!valid));
      return valid ? { age } : null;
    },
  };
}

function askChoice(
  field: "gender" | "artistic_background",
  options: { value: string; label: MessageKey }[],
  answer: (value: string) => Demographics,
): Question {
  const inputs = options.map(({ value }) =>
    element("input", { type: "radio", name: field, value }),
  );
  const labels = options.map(({ label }, index) =>
    element("label", { class: "option" }, inputs[index] as Node, message(label)),
  );
  const fault = element("p", { class: "fault", id: `${field}-fault`, role: "alert" });
  const view = element(
    "fieldset",
    { class: "question", "aria-describedby": `${field}-fault` },
    element("legend", {}, message(`demographics.${field}`)),
    element("div", { class: "options" }, ...labels),
    fault,
  );
  return {
    view,
    read() {
      const chosen = inputs.find((input) => input.checked);
      fault.textContent = chosen ? "" : message(`demographics.${field}.fault`);
      inputs[0]?.setAttribute("aria-invalid", String(!chosen));
      return chosen ? answer(chosen.value) : null;
    },
  };
}
