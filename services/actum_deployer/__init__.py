"""Writes what each host of a deployment needs: credentials, router, access control, compose file, units, README."""
