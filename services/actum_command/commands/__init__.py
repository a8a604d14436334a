"""The command line itself: options, help, printed texts, exit codes. The modules of `actum_command` do the work."""
