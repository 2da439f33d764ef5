"""One file a group of claims. Add a file here and it is in the next report; nothing else to edit."""
