"""One file for each task: from its answers to its results, sentences, tables and figures."""
