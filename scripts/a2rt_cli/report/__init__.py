"""Turns a folder of results into one self-contained HTML page.

measures.py    the paper's quantities, computed from results
words.py       the summary in plain words
stalls.py      what schedulers, RT units and lanes did with their cycles
gap.py         why our numbers differ from the paper's, as far as the results say
charts.py      bars as inline SVG; plots.py: lines and histograms
time_spent.py  the section "Where the time went"
sections.py    all that the main page is given
extras.py      sections and links that other modules may add
page.py        puts the main page together; price_page.py: the page of a sweep
"""
