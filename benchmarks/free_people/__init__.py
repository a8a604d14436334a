"""Simulated people who move freely, by random numbers: the background that ships is made of them."""
