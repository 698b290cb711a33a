"""The same study in a browser: server, store and front end."""
