"""Makes a fresh Debian 12 or 13 ready, step by step, and knows when there is nothing to do."""
