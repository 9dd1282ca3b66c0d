//! The order in which a sweep takes the springs or the points.

use super::sequence::Sequence;
use super::setting::Order;

/// The colour of each of these sets: the least that no earlier set has with which it shares a member. Sets of a colour share none.
pub fn colours<S: AsRef<[usize]>>(sets: &[S], members: usize) -> Vec<usize> {
    // The colours that sets of a member have.
    let mut taken: Vec<Vec<bool>> = vec![Vec::new(); members];
    let colour = |set: &S| {
        let set = set.as_ref();
        let is_free = |colour: &usize| set.iter().all(|&m| !taken[m].get(*colour).copied().unwrap_or(false));
        let colour = (0..).find(is_free).expect("a colour that no set has is free");
        for &m in set {
            if taken[m].len() <= colour {
                taken[m].resize(colour + 1, false);
            }
            taken[m][colour] = true;
        }
        colour
    };
    sets.iter().map(colour).collect()
}

/// The sets in the order of their colours; sets of one colour stay in their order.
fn by_colour<S: AsRef<[usize]>>(sets: &[S], members: usize) -> Vec<usize> {
    let colours = colours(sets, members);
    let mut order: Vec<usize> = (0..sets.len()).collect();
    // The sort is stable, which keeps the order within a colour.
    order.sort_by_key(|&set| colours[set]);
    order
}

impl<S: AsRef<[usize]>> Sequence<'_, S> {
    /// The springs in the order of a sweep.
    pub fn order(&self, order: Order) -> Vec<usize> {
        match order {
            Order::Colours => by_colour(self.springs, self.held.len()),
            Order::Given => (0..self.springs.len()).collect(),
            Order::Jolt => self.order_of_jolt(),
        }
    }
}

/// The colour of each point: two points that are in a spring together differ.
pub fn point_colours<S: AsRef<[usize]>>(springs: &[S], points: usize) -> Vec<usize> {
    // The sets of a point are the springs that it is in.
    let mut of_point: Vec<Vec<usize>> = vec![Vec::new(); points];
    for (s, spring) in springs.iter().enumerate() {
        spring.as_ref().iter().for_each(|&p| of_point[p].push(s));
    }
    colours(&of_point, springs.len())
}

/// The points in the order of a sweep of vertex block descent. Points of a colour are in no spring together.
pub(super) fn point_order<S: AsRef<[usize]>>(order: Order, springs: &[S], points: usize) -> Vec<usize> {
    let mut all: Vec<usize> = (0..points).collect();
    if order == Order::Colours {
        let colours = point_colours(springs, points);
        all.sort_by_key(|&point| colours[point]);
    }
    all
}
