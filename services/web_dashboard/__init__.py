"""The web page: what people see of a running system, and where they mark and teach, in any browser."""
