"""Simulated participants: observers with known answers, viewers with known gaze."""
