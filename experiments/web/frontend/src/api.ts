/** The server's interface for participants: its messages and the calls. Times are in seconds. */

import { ApiError } from "./retry";

const TIMEOUT_S = 20;

export type DemographicsField = "age" | "gender" | "artistic_background";
export type Gender = "female" | "male" | "other" | "undisclosed";
export type Task = "odd-one-out" | "two-alternative" | "yes-no" | "ranking" | "pick";
/**
 * By task: a label, a place from 1, 1 for yes and 0 for no, the rank of each image shown, or the
 * labels picked, from the smallest on.
 */
export type AnswerValue = number | number[];
export type Closed = "paused" | "full" | "busy";
export type Gamut = "srgb" | "p3" | "rec2020";
export type InputKind = "mouse" | "touch" | "keyboard" | "none";

/** What a participant says of themself; only the fields that the study lists. */
export interface Demographics {
  age?: number;
  gender?: Gender;
  artistic_background?: boolean;
}

/** What a study asks of the screen. */
export interface ScreenRules {
  minimum_width_px: number;
  minimum_height_px: number;
  color_gamut: Gamut | null;
  allow_zoom: boolean;
  rule: "refuse" | "flag";
  fullscreen: boolean;
  calibrate: boolean;
  distance: boolean;
}

/** What everybody may know of a study. `example` is no trial, so its answer is no secret. */
export interface Study {
  study: string;
  title: string;
  question: string;
  instructions: string[];
  language: string;
  task: Task;
  /** Of `odd-one-out` and `pick` only. */
  choices: number | null;
  consent: { version: string; text: string };
  demographics: DemographicsField[];
  screen: ScreenRules;
  /** What of the address is kept, the first telling who comes; whether nobody may come without. */
  recruitment: { parameters: string[]; required: boolean };
  timing: {
    blank_s: number;
    image_s: number | null;
    mask_s: number | null;
    time_limit_s: number | null;
  };
  answers: {
    labels: [string, string] | null;
    ties: boolean;
    /** How many objects are picked, at least and at most; of `pick` only. */
    picks: [number, number] | null;
  };
  example: (Picture & { answer: AnswerValue }) | null;
  /** Why nobody may begin now, or null where they may. */
  closed: Closed | null;
}

/** What a participant leaves with. */
export interface Completion {
  completion_code: string;
  /** Where to go with it, or null. */
  completion_url: string | null;
}

/** A session's id and the secret that opens it. */
export interface Credentials {
  session: string;
  token: string;
}

/** An image; `image` and `regions` are addresses that say nothing about the contents. */
export interface Picture {
  image: string;
  regions: string | null;
  width_px: number;
  height_px: number;
}

/** One presentation: the images that are shown in it, in their places. */
export interface Trial {
  index: number;
  phase: "practice" | "main";
  pictures: Picture[];
  feedback: boolean;
}

/** What is known beforehand of a session in which the answers decide what comes next. */
export interface Adaptive {
  /** How many trials there are at most, practice included. */
  limit: number;
  practice: number;
  /** Every picture that may be shown. */
  pictures: Picture[];
}

/** A session as the server knows it. */
export interface Session {
  session: string;
  participant: string;
  participant_number: number;
  /** All trials; of an adaptive design those that are answered, and the next one. */
  trials: Trial[];
  adaptive: Adaptive | null;
  answered: number[];
  complete: boolean;
  completion_code: string | null;
  completion_url: string | null;
}

/** Label and length of each run of equal labels, row by row; label 0 is the background. */
export interface RegionRuns {
  width_px: number;
  height_px: number;
  runs: [label: number, length: number][];
}

/** An answer with what was measured; `answer` is null when the time limit passed. */
export interface Answer {
  id: string;
  trial_index: number;
  answer: AnswerValue | null;
  reaction_time_s: number | null;
  onset_requested_s: number;
  onset_measured_s: number;
  frame_interval_s: number | null;
  dropped_frames: number;
  input: InputKind;
}

export interface Feedback {
  correct: boolean;
  answer: AnswerValue;
}

export interface AnswerReply {
  stored: boolean;
  feedback: Feedback | null;
  /** Of an adaptive design: the trial that follows, or null at the end. */
  next?: Trial | null;
}

/** What is sent to open a session. */
export interface NewSession {
  consent_version: string;
  demographics: Demographics;
  screen: Record<string, number | string>;
  device: string;
  /** Drawn once: a beginning whose reply was lost is posted again, and begins nothing new. */
  arrival: string;
  recruitment: Record<string, string>;
  simulated: false;
}

export const api = {
  study: (name: string) => getJson<Study>(`/api/studies/${name}`),
  begin: (name: string, session: NewSession) =>
    post<Credentials>(`/api/studies/${name}/sessions`, null, session),
  session: ({ session, token }: Credentials) => getJson<Session>(sessionPath(session), token),
  complete: ({ session, token }: Credentials) =>
    post<Completion>(`${sessionPath(session)}/complete`, token, {}),
  comeBack: (name: string, recruitment: Record<string, string>) =>
    post<Credentials>(`/api/studies/${name}/return`, null, { recruitment }),
  keep: ({ session, token }: Credentials, page: string) =>
    post<null>(`${sessionPath(session)}/lease`, token, { page }),
  withdraw: ({ session, token }: Credentials) =>
    post<null>(`${sessionPath(session)}/withdrawal`, token, null),
};

/** The address below which everything of a session lies. */
export function sessionPath(session: string): string {
  return `/api/sessions/${encodeURIComponent(session)}`;
}

/** The id of a session's answer to a trial, the same however often it is made. */
export function answerId(session: string, trialIndex: number): string {
  return `${session}.${String(trialIndex).padStart(4, "0")}`;
}

export async function getJson<T>(path: string, token: string | null = null): Promise<T> {
  return (await (await request(path, token)).json()) as T;
}

export async function getBlob(path: string, token: string | null = null): Promise<Blob> {
  return (await request(path, token)).blob();
}

/** Post a JSON body and return the reply, or null where the reply is empty. */
export async function post<T>(path: string, token: string | null, body: unknown): Promise<T> {
  const response = await request(path, token, {
    method: "POST",
    headers: { "Content-Type": "application/json" },
    body: JSON.stringify(body),
  });
  return (response.status === 204 ? null : await response.json()) as T;
}

async function request(path: string, token: string | null, init: RequestInit = {}) {
  const headers = new Headers(init.headers);
  if (token !== null) {
    headers.set("Authorization", `Bearer ${token}`);
  }
  const signal = AbortSignal.timeout(1000 * TIMEOUT_S);
  const response = await fetch(path, { ...init, headers, signal });
  if (!response.ok) {
    throw await apiError(response);
  }
  return response;
}

async function apiError(response: Response): Promise<ApiError> {
  const body: unknown = await response.json().catch(() => null);
  const error = (body as { error?: { code?: string; message?: string } } | null)?.error;
  return new ApiError(
    response.status,
    error?.code ?? "unknown",
    error?.message ?? response.statusText,
    body,
  );
}
