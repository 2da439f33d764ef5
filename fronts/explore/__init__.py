"""``fronts explore``: a page in the browser with sliders for the parameters.

`fronts.explore.calls` defines the calls of public functions from which the pictures are made; the
Python code shown on the page is the text of the same calls. `fronts.explore.page` draws the
pictures and serves the page.

The page is made with Panel. Marimo and Panel both install offline and serve all resources that a
page needs. In marimo a slider runs notebook cells again, and a changed picture is sent and laid out
as a whole. With Panel the plots are drawn by Bokeh in the browser, and moving a slider sends only
the numbers that have changed, so that zoom and hover persist and Matplotlib is not called at all.
Moreover, Panel is an ordinary library: the page is a Python module that the type checker can read,
whereas a marimo notebook is a file in its own format.
"""
