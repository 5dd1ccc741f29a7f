"""What a run means, from its log: summary.json and a report to read and to print. Uses files/, log/, log_reading/, session/."""
