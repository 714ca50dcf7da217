"""Migrations, one file per released schema."""
