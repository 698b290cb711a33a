"""Which trials a session has and why: fixed and adaptive designs, and their replay."""
