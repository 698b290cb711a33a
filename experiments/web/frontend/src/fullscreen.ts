/** The full screen, where a study asks for it; call it within a press of a button. */

/** Ask for the full screen; false where the browser refuses it, as phones do. */
export async function enterFullscreen(): Promise<boolean> {
  try {
    await document.documentElement.requestFullscreen({ navigationUI: "hide" });
    return true;
  } catch {
    return false;
  }
}

/** Give the screen back. */
export async function leaveFullscreen(): Promise<void> {
  if (document.fullscreenElement !== null) {
    await document.exitFullscreen().catch(() => {});
  }
}
