"""All that runs beside each other in a served robot, against each other, with a switch of threads every 20 us."""
