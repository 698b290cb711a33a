/** Waiting for a participant's answer: a press on an object, its number key, or the time limit. */

import type { InputKind } from "./api";

/** What answers can be chosen on: pictures, regions of pictures, buttons. */
export interface Choosable {
  /** Where presses of a pointer are listened to. */
  readonly area: HTMLElement;
  /** The button of each number, for the keyboard and assistive technology. */
  readonly numbers: ReadonlyMap<number, HTMLButtonElement>;
  /** Return the number that a pointer event points at; 0 for none. */
  labelOf(event: PointerEvent): number;
}

const NONE = 0;

/** An answer as given. */
export interface GivenAnswer {
  /** The number chosen, or null when the time limit passed. */
  answer: number | null;
  /** When the pointer or the key went down, seconds on the animation clock; null with no answer. */
  given_s: number | null;
  input: InputKind;
}

/**
 * Resolve with the first answer.
 *
 * A press with the pointer counts when it begins and ends on the same object, so that a slip can
 * be taken back; its time is that of its beginning.
 *
 * @param numberOf - The number that a key stands for, or null.
 * @param timeLimit_s - How long to wait, or null for as long as it takes.
 */
export function waitForAnswer(
  choosable: Choosable,
  numberOf: (event: KeyboardEvent) => number | null,
  timeLimit_s: number | null,
): Promise<GivenAnswer> {
  return new Promise((resolve) => {
    const done = new AbortController();
    const finish = (answer: GivenAnswer) => {
      done.abort();
      resolve(answer);
    };
    listenToPointer(choosable, done.signal, finish);
    listenToKeys(numberOf, done.signal, finish);
    listenToButtons(choosable, done.signal, finish);
    if (timeLimit_s !== null) {
      const none: GivenAnswer = { answer: null, given_s: null, input: "none" };
      const timer = setTimeout(() => finish(none), 1000 * timeLimit_s);
      done.signal.addEventListener("abort", () => clearTimeout(timer));
    }
  });
}

/**
 * Return the number that a key stands for, or null.
 *
 * The digit row counts by its place: on some layouts it types digits only with Shift held.
 */
export function numberOfKey(event: KeyboardEvent, choices: number): number | null {
  if (!isPlain(event)) {
    return null;
  }
  const digit = /^(?:Digit|Numpad)([1-9])$/.exec(event.code)?.[1] ?? /^[1-9]$/.exec(event.key)?.[0];
  const number = Number(digit ?? 0);
  return number >= 1 && number <= choices ? number : null;
}

/** Return the number, of two, that a key stands for: 1 or the left arrow, 2 or the right one. */
export function numberOfTwo(event: KeyboardEvent): number | null {
  const arrow = ["ArrowLeft", "ArrowRight"].indexOf(event.key) + 1;
  const numeral = numberOfKey(event, 2);
  return numeral ?? (arrow > 0 && event.code === event.key && isPlain(event) ? arrow : null);
}

function isPlain(event: KeyboardEvent): boolean {
  return !(event.repeat || event.ctrlKey || event.altKey || event.metaKey);
}

type Finish = (answer: GivenAnswer) => void;

function listenToPointer(choosable: Choosable, signal: AbortSignal, finish: Finish): void {
  let press: { pointer: number; label: number; given_s: number } | null = null;
  const down = (event: PointerEvent) => {
    const label = event.isPrimary && event.button === 0 ? choosable.labelOf(event) : NONE;
    press = { pointer: event.pointerId, label, given_s: event.timeStamp / 1000 };
  };
  const up = (event: PointerEvent) => {
    const same = press?.pointer === event.pointerId && press.label === choosable.labelOf(event);
    if (same && press !== null && press.label !== NONE) {
      const input = event.pointerType === "touch" ? "touch" : "mouse";
      finish({ answer: press.label, given_s: press.given_s, input });
    }
    press = null;
  };
  const cancel = () => {
    press = null;
  };
  choosable.area.addEventListener("pointerdown", down, { signal });
  choosable.area.addEventListener("pointerup", up, { signal });
  choosable.area.addEventListener("pointercancel", cancel, { signal });
}

function listenToKeys(
  numberOf: (event: KeyboardEvent) => number | null,
  signal: AbortSignal,
  finish: Finish,
): void {
  const down = (event: KeyboardEvent) => {
    const answer = numberOf(event);
    if (answer !== null) {
      finish({ answer, given_s: event.timeStamp / 1000, input: "keyboard" });
    }
  };
  document.addEventListener("keydown", down, { signal });
}

/** The number buttons, pressed from the keyboard or by assistive technology (no pointer). */
function listenToButtons({ numbers }: Choosable, signal: AbortSignal, finish: Finish): void {
  for (const [answer, button] of numbers) {
    const click = (event: MouseEvent) => {
      if (event.detail === 0) {
        finish({ answer, given_s: event.timeStamp / 1000, input: "keyboard" });
      }
    };
    button.addEventListener("click", click, { signal });
  }
}
