"""The wedge micro-model of asymmetric friction: coefficients from the slopes and local friction of asperities.

Source: Antoni, Ligier, Saffré, Pastor (2007), section 2, Eqs. (2)-(18).
"""
