"""Mechanism synthesis, with commented scenes as output."""
