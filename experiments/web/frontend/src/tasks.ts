/** What each task shows and asks: its plugin with parameters, and what its feedback shows. */

import type { AnswerValue, Study, Trial } from "./api";
import { message } from "./messages";
import { PictureRow, pairNames, pairRow, pictureOf } from "./picture-row";
import OddOneOutPlugin from "./plugins/odd-one-out";
import PickPlugin from "./plugins/pick";
import RankingPlugin from "./plugins/ranking";
import TwoAlternativePlugin from "./plugins/two-alternative";
import YesNoPlugin from "./plugins/yes-no";
import { RankingBoard } from "./ranking-board";
import { Stage } from "./stage";
import type { Exhibit, Stimulus } from "./stimulus";

type Plugin =
  | typeof OddOneOutPlugin
  | typeof TwoAlternativePlugin
  | typeof YesNoPlugin
  | typeof RankingPlugin
  | typeof PickPlugin;

/** A trial of some task. */
export interface Presentation {
  /** The plugin and those of its parameters that only this task has. */
  ask: { type: Plugin } & Record<string, unknown>;
  /** Return what the feedback shows. */
  exhibit(): Exhibit<never>;
  /** Say which answer is right. */
  name(answer: AnswerValue): string;
}

/** Return how a trial of the study's task is presented. */
export function presentationOf(study: Study, trial: Trial, stimuli: Stimulus[]): Presentation {
  return TASKS[study.task](study, stimuli, trial);
}

type Present = (study: Study, stimuli: Stimulus[], trial: Trial) => Presentation;

const TASKS: Record<Study["task"], Present> = {
  "odd-one-out": ({ choices }, stimuli) => ({
    ask: { type: OddOneOutPlugin, choices },
    exhibit: () => new Stage(...(stimuli as [Stimulus]), choices ?? 0),
    name: (answer) => message("odd_one_out.right", { answer: String(answer) }),
  }),
  pick: ({ choices, answers }, stimuli) => ({
    ask: { type: PickPlugin, choices, picks: answers.picks },
    exhibit: () => new Stage(...(stimuli as [Stimulus]), choices ?? 0),
    name: (answer) => message("pick.right", { answer: [answer].flat().join(", ") }),
  }),
  "two-alternative": ({ timing }, stimuli, { index }) => ({
    ask: { type: TwoAlternativePlugin, ...durations(timing), seed: index },
    exhibit: () => pairRow(stimuli as [Stimulus, Stimulus]),
    name: (answer) =>
      message("pair.right", {
        image: pairNames(timing.mask_s !== null)[Number(answer) - 1] ?? "",
      }),
  }),
  "yes-no": ({ timing, answers }, stimuli) => {
    const labels = answers.labels ?? [message("yes_no.yes"), message("yes_no.no")];
    return {
      ask: { type: YesNoPlugin, image_s: timing.image_s, labels },
      exhibit: () => new PictureRow(stimuli.map((one) => pictureOf(one, message("yes_no.image")))),
      name: (answer) => message("yes_no.right", { answer: labels[answer === 1 ? 0 : 1] }),
    };
  },
  ranking: ({ answers }, stimuli) => {
    const ends = answers.labels ?? [message("ranking.best"), message("ranking.worst")];
    const { ties } = answers;
    return {
      ask: { type: RankingPlugin, ends, ties },
      exhibit: () => new RankingBoard(stimuli, { ends, ties: false }),
      name: () => message("ranking.right"),
    };
  },
};

function durations({ image_s, mask_s }: Study["timing"]) {
  return { image_s, mask_s };
}
