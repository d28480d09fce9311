"""Many cheap cases in one test: pytest takes longer to set up a test than most of them last."""

import functools
import inspect
import re
from collections.abc import Callable, Iterable

import pytest


def each(names: str, cases: Iterable) -> Callable[[Callable], Callable]:
    """Run a test for each case, as `pytest.mark.parametrize` does with a test of its own; a failure names its case."""
    wanted, cases = [name.strip() for name in names.split(",")], list(cases)

    def decorate(test: Callable) -> Callable:
        @functools.wraps(test)
        def of_all(**fixtures: object) -> None:
            for case in cases:
                values = case if len(wanted) > 1 else (case,)
                try:
                    test(**dict(zip(wanted, values, strict=True)), **fixtures)
                except BaseException as error:
                    error.add_note(f"in case {case!r}")
                    raise

        signature = inspect.signature(test)
        left = [parameter for name, parameter in signature.parameters.items() if name not in wanted]
        of_all.__signature__ = signature.replace(parameters=left)
        return of_all

    return decorate


def refusals(make: Callable, *cases: tuple) -> Callable[[], None]:
    """Make a test: what `make` is given of a case is refused in the words that end it; … stands for any text."""

    @each("case", cases)
    def test(case: tuple) -> None:
        *given, words = case
        with pytest.raises(ValueError, match="(?s)" + ".*".join(map(re.escape, words.split(" … ")))):
            make(*given)

    return test
