"""Turns a folder of results into one self-contained HTML page.

measures.py   the paper's quantities, computed from results
words.py      the summary in plain words
charts.py     bars as inline SVG
sections.py   what the template is given
page.py       puts it together
"""
