"""The features of the server, each in a folder that can be deleted; see `app.feature`."""
