"""A lab journal as a feature of Racing Hexapods: `feature`, `routes`, `tables`, `migrations`."""
