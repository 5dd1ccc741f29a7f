"""The app served for an hour to three clients who do whatever they may."""
