"""What people touch: command line, web app, sessions, recording, reports. The only place with files and sockets."""
