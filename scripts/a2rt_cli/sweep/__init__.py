"""Resumable experiments.

plan.py       an experiment as a list of captures and points, written to OUT/plan.json
workflow.py   starts Snakemake on that plan
worker.py     what one workflow job runs
search.py     an optimiser over the same points
"""
