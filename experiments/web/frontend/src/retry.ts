/** Trying again, ever more slowly, what failed only for the moment. */

export const FIRST_DELAY_S = 0.5;
export const LONGEST_DELAY_S = 15;

/** An answer of the server other than success. */
export class ApiError extends Error {
  override name = "ApiError";

  /**
   * @param status - The HTTP status.
   * @param code - The server's short code of the error.
   * @param body - The whole reply as parsed JSON, or null.
   */
  constructor(
    readonly status: number,
    readonly code: string,
    message: string,
    readonly body: unknown = null,
  ) {
    super(message);
  }
}

/** Tell whether the same request may succeed later: no reply at all, or a passing condition. */
export function isTransient(error: unknown): boolean {
  if (error instanceof ApiError) {
    return error.status >= 500 || error.status === 408 || error.status === 429;
  }
  // What `fetch` throws without a connection, and after `AbortSignal.timeout`.
  return (
    error instanceof TypeError || (error instanceof DOMException && error.name === "TimeoutError")
  );
}

/**
 * Call `attempt` until it succeeds or fails for good.
 *
 * The delay doubles from `FIRST_DELAY_S` to `LONGEST_DELAY_S`, each shortened at random by up to
 * half so that many participants do not come back in the same instant; a browser that reports a
 * connection again tries at once.
 *
 * @param onFailure - Called after every passing failure, before the wait.
 * @throws The first error that is not transient.
 */
export async function retry<T>(attempt: () => Promise<T>, onFailure = () => {}): Promise<T> {
  for (let delay_s = FIRST_DELAY_S; ; delay_s = Math.min(2 * delay_s, LONGEST_DELAY_S)) {
    try {
      return await attempt();
    } catch (error) {
      if (!isTransient(error)) {
        throw error;
      }
      onFailure();
      await delayUntilOnline(delay_s * (1 - Math.random() / 2));
    }
  }
}

function delayUntilOnline(delay_s: number): Promise<void> {
  return new Promise((resolve) => {
    const finish = () => {
      clearTimeout(timer);
      window.removeEventListener("online", finish);
      resolve();
    };
    const timer = setTimeout(finish, 1000 * delay_s);
    window.addEventListener("online", finish);
  });
}
