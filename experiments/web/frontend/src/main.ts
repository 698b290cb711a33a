/** The participant's page: from consent to thanks, or from where an earlier visit stopped. */

import { initJsPsych } from "jspsych";
import { api, type Credentials, type Session, type Study } from "./api";
import { element } from "./dom";
import { message, setLanguage } from "./messages";
import { Notice } from "./notice";
import { beginSession, findSession, findStudy, leaveIfAsked } from "./opening";
import { type Example, showInstructions } from "./pages/instructions";
import { showLoading } from "./pages/loading";
import { showProblem } from "./pages/problem";
import { showResume } from "./pages/resume";
import { showSending, showThanks } from "./pages/thanks";
import { apiLoader, preload } from "./preload";
import { Recorder } from "./recorder";
import { ApiError, retry } from "./retry";
import { makeTimeline } from "./timeline";
import "./styles/base.css";
import "./styles/pages.css";
import "./styles/trial.css";

const root = element("div", { id: "page" });
document.body.append(root);
const notice = new Notice(document.body);

setLanguage(navigator.language); // until the study says its own
takePart(studyName(location.pathname)).catch((error: unknown) => {
  const reason = error instanceof Error ? error.message : String(error);
  showProblem(root, message("problem.unexpected", { reason }));
});

async function takePart(name: string): Promise<void> {
  const study = await findStudy(root, name);
  if (study === null) {
    showProblem(root, message("problem.unknown_study"));
    return;
  }
  document.title = study.title;
  document.documentElement.lang = study.language;
  setLanguage(study.language);
  leaveIfAsked(name);
  const earlier = await findSession(root, name);
  const credentials = earlier?.credentials ?? (await beginSession(root, study));
  if (credentials !== null) {
    await continueSession(study, credentials, earlier?.session ?? null);
  }
}

/** @param earlier - The session as a returning participant left it, or null for a new one. */
async function continueSession(
  study: Study,
  credentials: Credentials,
  earlier: Session | null,
): Promise<void> {
  const session = earlier ?? (await retry(() => api.session(credentials)));
  if (session.completion_code !== null) {
    showThanks(root, session.completion_code);
    return;
  }
  const recorder = await Recorder.open(credentials, notice);
  const answered = new Set([...session.answered, ...recorder.unsentTrials()]);
  const open = session.trials.filter((trial) => !answered.has(trial.index));
  if (earlier !== null) {
    recorder.event("resume", { answered: answered.size });
    await showResume(root, answered.size, session.trials.length);
  } else {
    await instruct(study, session);
  }
  const stimuli = await preload(open, apiLoader(credentials.token), showLoading(root));
  await runTrials(makeTimeline(study, session.trials, stimuli, recorder), recorder);
  await finish(credentials, recorder);
}

async function instruct(study: Study, session: Session): Promise<void> {
  const practice = session.trials.some((trial) => trial.phase === "practice");
  await showInstructions(root, study, await loadExample(study), practice);
}

async function loadExample({ example }: Study): Promise<Example | null> {
  if (example === null) {
    return null;
  }
  const loaded = await preload([{ index: 0, pictures: [example] }], apiLoader(null));
  const stimulus = loaded.get(0)?.[0];
  return stimulus === undefined ? null : { stimulus, answer: example.answer };
}

async function runTrials(
  timeline: ReturnType<typeof makeTimeline>,
  recorder: Recorder,
): Promise<void> {
  if (timeline.length === 0) {
    return;
  }
  const watching = new AbortController();
  recorder.watchWindow(watching.signal);
  root.replaceChildren();
  const jsPsych = initJsPsych({ display_element: root, use_webaudio: false });
  await jsPsych.run(timeline);
  watching.abort();
}

/** Wait for the acknowledgement of every answer; only then is the session complete. */
async function finish(credentials: Credentials, recorder: Recorder): Promise<void> {
  showSending(root);
  await recorder.allSent();
  try {
    const { completion_code } = await retry(() => api.complete(credentials));
    showThanks(root, completion_code);
  } catch (error) {
    if (!(error instanceof ApiError)) {
      throw error;
    }
    const missing = (error.body as { missing?: number[] } | null)?.missing?.length ?? 0;
    const { session } = credentials;
    showProblem(root, message("problem.incomplete", { missing, session }));
  }
}

function studyName(path: string): string {
  return /^\/s\/([^/]+)/.exec(path)?.[1] ?? "";
}
