//! Which values a printer gives a name: those that are used more than once, or outside the loop in which they are made.

use super::function::{Function, Result, Role, Statement};
use super::node::Node;

/// The largest number of operations of an expression on one line.
// With it lines are about as wide as those of tables, 100 characters.
const LONGEST: usize = 12;

/// How the values of a function are used.
#[derive(Debug)]
pub struct Uses {
    /// How often each value is used by steps and other used values.
    counts: Vec<usize>,
    /// The values that have a name.
    named: Vec<bool>,
}

impl Uses {
    /// Those of this function.
    pub fn of(function: &Function) -> Uses {
        let count = function.nodes.len();
        let mut uses = Uses { counts: vec![0; count], named: vec![false; count] };
        // The block in which each value is made and, unless there are several, used.
        let mut made = vec![0; count];
        let mut used: Vec<Option<usize>> = vec![None; count];
        let mut blocks = 0;
        if let Result::Value(value) = function.result {
            uses.counts[value] = 2;
        }
        uses.count_steps(&function.steps, 0, &mut blocks, &mut made, &mut used);
        // Operands are made before the values that use them.
        for value in (0..count).rev() {
            if uses.counts[value] > 0 {
                function.nodes[value].operands().into_iter().for_each(|operand| {
                    uses.count_use(operand, made[value], &mut used);
                });
            }
        }
        let mut sizes = vec![1; count];
        for value in 0..count {
            let node = &function.nodes[value];
            let of = |operand: &usize| if uses.named[*operand] { 1 } else { sizes[*operand] };
            sizes[value] = 1 + node.operands().iter().map(of).sum::<usize>();
            let is_written = matches!(node, Node::Entry { array, .. }
                if matches!(function.arrays[*array].role, Role::Work | Role::Output));
            let is_plain = match node {
                Node::Number(_) | Node::Parameter(_) => true,
                Node::Entry { .. } => !is_written && uses.counts[value] <= 1,
                _ => false,
            };
            let elsewhere = used[value].is_some_and(|block| block != made[value]);
            uses.named[value] = !is_plain
                && (uses.counts[value] > 1 || elsewhere || is_written || sizes[value] > LONGEST)
                && uses.counts[value] > 0;
        }
        uses
    }

    fn count_use(&mut self, value: usize, block: usize, used: &mut [Option<usize>]) {
        self.counts[value] += 1;
        used[value].get_or_insert(block);
    }

    fn count_steps(
        &mut self,
        steps: &[Statement],
        block: usize,
        blocks: &mut usize,
        made: &mut [usize],
        used: &mut [Option<usize>],
    ) {
        for step in steps {
            match step {
                Statement::Value(value) => made[*value] = block,
                Statement::Store { value, .. } => self.count_use(*value, block, used),
                Statement::Guard { greater, than, .. } => {
                    self.count_use(*greater, block, used);
                    self.count_use(*than, block, used);
                }
                Statement::Loop { body, .. } => {
                    *blocks += 1;
                    let inner = *blocks;
                    self.count_steps(body, inner, blocks, made, used);
                }
            }
        }
    }

    /// Whether the value has a name.
    pub fn is_named(&self, value: usize) -> bool {
        self.named[value]
    }
}
