"""``fronts explore``: a page in the browser in which the parameters are sliders.

`fronts.explore.calls` says which calls of the public functions make the pictures; what the page
shows as Python is the text of these same calls. `fronts.explore.page` draws and serves them.

The page is made with Panel. Of marimo and Panel, both install offline and serve everything that a
page needs themselves. In marimo a slider runs cells of a notebook again, and a picture that has
changed is sent and laid out whole; with Panel the plots are Bokeh's, drawn by the browser, and a
slider sends the numbers that have changed, so that zoom and hover stay and Matplotlib is not called
at all. Panel is also a library beside others: the page is an ordinary module that the type checker
reads, where a marimo notebook is a file of its own format.
"""
