"""A small mutator over the translators: a flipped sign or swapped axis must fail a test."""
