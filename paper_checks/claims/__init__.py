"""One file a group of claims. A file added here is in the next report; nothing else to edit."""
