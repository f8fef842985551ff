//! The page of `cost`.

use maud::html;

use super::document::{Picture, command_line, document, figure, machine_list, version_list, words};
use crate::report::record::cost::Cost;
use crate::report::words::cost::table;
use crate::report::words::number::{plain, short};

pub fn html(cost: &Cost, pictures: &[Picture]) -> String {
    let body = html! {
        p.description { (cost.model) }
        @for picture in pictures { (figure(picture)) }
        (words(&table(cost)))
        p.small {
            "CPU time of the stepping alone at a step of " (short(cost.step_s)) " s, on one thread, engines in turns, \
             median of the rounds, over the first " (plain(cost.timed_s, 4)) " s or the part of it that takes 0.4 s."
        }
        (machine_list(&cost.machine))
        (version_list(&cost.versions))
        (command_line(&cost.command))
    };
    document("Cost of a step", body)
}
