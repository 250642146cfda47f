"""Mitsuba's rough surfaces with the masking that woodcock has.

Both mask the tiny mirrors of a GGX surface after Smith. Mitsuba multiplies what either direction sees, woodcock takes
into account that both see the same heights (Heitz 2014, equations 98 and 99):

    separable   G = 1 / ((1 + L(v)) (1 + L(w)))         correlated   G = 1 / (1 + L(v) + L(w))

`Correlated` wraps a BSDF of Mitsuba and multiplies what it returns by the ratio of the two.
"""

import drjit as dr
import mitsuba as mi


class Correlated(mi.BSDF):
    def __init__(self, props):
        super().__init__(props)
        self.nested = props["nested"]
        self.alpha_u = props["alpha_u"]
        self.alpha_v = props["alpha_v"]
        self.m_components = [self.nested.flags(i) for i in range(self.nested.component_count())]
        self.m_flags = self.nested.flags()

    def hidden(self, w):
        """L of Smith: what hides over what is seen."""
        x, y = self.alpha_u * w.x, self.alpha_v * w.y
        return 0.5 * (dr.sqrt(1 + (x * x + y * y) / (w.z * w.z)) - 1)

    def ratio(self, v, w):
        a, b = self.hidden(v), self.hidden(w)
        ratio = 1 + a * b / (1 + a + b)
        return dr.select(dr.isfinite(ratio), ratio, 0)

    def sample(self, ctx, si, sample1, sample2, active=True):
        sample, weight = self.nested.sample(ctx, si, sample1, sample2, active)
        return sample, weight * self.ratio(si.wi, sample.wo)

    def eval(self, ctx, si, wo, active=True):
        return self.nested.eval(ctx, si, wo, active) * self.ratio(si.wi, wo)

    def pdf(self, ctx, si, wo, active=True):
        return self.nested.pdf(ctx, si, wo, active)

    def eval_pdf(self, ctx, si, wo, active=True):
        value, pdf = self.nested.eval_pdf(ctx, si, wo, active)
        return value * self.ratio(si.wi, wo), pdf

    def traverse(self, callback):
        callback.put("nested", self.nested, mi.ParamFlags.Differentiable)

    def to_string(self):
        return f"Correlated[{self.nested}]"


mi.register_bsdf("correlated", Correlated)


def correlated(nested, alpha_u, alpha_v):
    return {"type": "correlated", "nested": nested, "alpha_u": alpha_u, "alpha_v": alpha_v}
