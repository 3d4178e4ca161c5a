"""Higher costs are marked, lower ones are not."""

import unittest

import check_hot_loops


def figures(instructions, allocations=0, allocated_bytes=0):
    return {"instructions": instructions, "allocations": allocations, "allocated_bytes": allocated_bytes}


class Compare(unittest.TestCase):
    def test_a_tenth_more_is_allowed(self):
        lines, too_much = check_hot_loops.compare({"track": figures(100, 10)}, {"track": figures(110, 11)})
        self.assertFalse(too_much)
        self.assertIn("(1.10)", lines[1])
        self.assertNotIn("!", lines[1])

    def test_more_is_marked(self):
        kept = {"track": figures(100), "match": figures(100)}
        lines, too_much = check_hot_loops.compare(kept, {"track": figures(90), "match": figures(111)})
        self.assertTrue(too_much)
        self.assertNotIn("!", lines[1])
        self.assertIn("111 (1.11)!", lines[2])

    def test_the_first_allocation_is_too_much(self):
        self.assertFalse(check_hot_loops.compare({"blur": figures(100)}, {"blur": figures(100)})[1])
        self.assertTrue(check_hot_loops.compare({"blur": figures(100)}, {"blur": figures(100, 1, 64)})[1])


if __name__ == "__main__":
    unittest.main()
