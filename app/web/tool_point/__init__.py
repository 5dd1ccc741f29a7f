"""The tool centre point from poses in which the tool touches one point. Uses web/widgets/."""
