(* Lemma 6: without a right of way, two shields never disagree about who comes first within one stretch of rest. *)
Require Import Reals Lra Lia Psatz Arith.
Require Import Contract Shipped Motion Reach Statement Ego Precedence Turns.
Open Scope R_scope.

Section Order.
Variables (k : contract) (v : bool -> R -> R) (arrival : bool -> R) (from r : R) (m : nat).
Hypothesis ok : valid k.
Hypothesis keeps : forall x, keeps_contract k (v x) from.
Hypothesis en : enough k m.
Hypothesis jitter_small : jitter k <= period k / 8.

(* What a shield counts and knows of each of both vehicles, on its grid g and its own clock. *)
Record knows (g : nat -> R) (sure ended : bool -> nat -> Prop) (S_ : bool -> nat -> nat) (L : bool -> nat -> option nat)
    (offset : R) (after by_ : bool -> R) : Prop := {
  its_grid : on_grid k g;
  its_begin : from <= g 0%nat;
  its_sure : forall x i, sure x i -> v x (g i) <= r /\ arrival x <= g i;
  its_ended : forall x i, ended x i -> Precedence.ended k (v x) r g (arrival x) m i;
  its_S : forall x i, (S_ x i <= i + 1)%nat /\ forall j, (j <= i)%nat -> (i < j + S_ x i)%nat -> sure x j;
  its_L : forall x i l, L x i = Some l -> (l <= i)%nat /\ ended x (i - l)%nat;
  its_arrivals : forall x, knows_arrival offset (arrival x) (after x) (by_ x)
}.

(* By the shield's own values at call i, vehicle a comes before the other one. *)
Definition before (S_ : bool -> nat -> nat) (L : bool -> nat -> option nat) (after by_ : bool -> R) (a : bool) (i : nat) :=
  exists l, L (negb a) i = Some l /\
    (after (negb a) - by_ a) + (INR (S_ a i) - INR l) * period k > period k.

(* Two shields do not say the opposite, if no count of the second one has ended between the two calls. *)
Lemma orders_exclude p sure_p ended_p S_p L_p o after by_ q sure_q ended_q S_q L_q o' after' by' a i j :
  knows p sure_p ended_p S_p L_p o after by_ -> knows q sure_q ended_q S_q L_q o' after' by' ->
  p i <= q j -> (forall l, L_q a j = Some l -> q (j - l)%nat <= p i) ->
  before S_p L_p after by_ a i -> ~ before S_q L_q after' by' (negb a) j.
Proof.
  intros P Q order no_end (lB & LB & sumP) (lA & LA & sumQ).
  rewrite Bool.negb_involutive in *.
  specialize (no_end lA LA).
  assert (p0 : 0 < period k) by (destruct ok; lra).
  pose proof (its_grid _ _ _ _ _ _ _ _ P) as gp. pose proof (its_grid _ _ _ _ _ _ _ _ Q) as gq.
  destruct (its_L _ _ _ _ _ _ _ _ P _ i lB LB) as (lBi & endB).
  destruct (its_L _ _ _ _ _ _ _ _ Q _ j lA LA) as (lAj & endA).
  pose proof (its_ended _ _ _ _ _ _ _ _ P _ _ endB) as endB'. pose proof (its_ended _ _ _ _ _ _ _ _ Q _ _ endA) as endA'.
  destruct (its_S _ _ _ _ _ _ _ _ P a i) as [shortA stretchA].
  destruct (its_S _ _ _ _ _ _ _ _ Q (negb a) j) as [shortB stretchB].
  set (eB := (i - lB)%nat) in *. set (eA := (j - lA)%nat) in *.
  set (sA := (i + 1 - S_p a i)%nat). set (sB := (j + 1 - S_q (negb a) j)%nat).
  assert (next : forall g x, on_grid k g -> g x < g (x + 1)%nat).
  { intros g x gg. pose proof (spacing k g gg x 1) as [A _]. simpl INR in A. destruct ok. lra. }
  (* Each stretch of rest began after the other shield's count of that vehicle ended. *)
  assert (beganA : q eA < p sA).
  { destruct (le_lt_dec (S_p a i) 0) as [none | some].
    - replace sA with (i + 1)%nat by (unfold sA; lia). pose proof (next p i gp). lra.
    - apply (stretch_began k (v a) from r ok (keeps a) q p gq gp (arrival a) m sA i (sure_p a) eA en
               (its_begin _ _ _ _ _ _ _ _ Q) (its_sure _ _ _ _ _ _ _ _ P a)); auto; [| unfold sA; lia |].
      + intros x hx. apply stretchA; unfold sA in hx; lia.
      + pose proof (next p i gp). lra. }
  assert (beganB : p eB < q sB).
  { assert (p eB <= p i) by (apply (calls_ordered k p ok gp); unfold eB; lia).
    pose proof (next q j gq).
    destruct (le_lt_dec (S_q (negb a) j) 0) as [none | some].
    - replace sB with (j + 1)%nat by (unfold sB; lia). lra.
    - apply (stretch_began k (v (negb a)) from r ok (keeps (negb a)) p q gp gq (arrival (negb a)) m sB j (sure_q (negb a)) eB en
               (its_begin _ _ _ _ _ _ _ _ P) (its_sure _ _ _ _ _ _ _ _ Q (negb a))); auto; [| unfold sB; lia | lra].
      intros x hx. apply stretchB; unfold sB in hx; lia. }
  (* One grid for the calls of both. *)
  destruct gp as [sp GP]. destruct gq as [sq GQ].
  pose proof (GQ eA) as A1. pose proof (GP sA) as A2. pose proof (GP eB) as B1. pose proof (GQ sB) as B2.
  assert (gained : (INR eA + INR eB) * period k < (INR sA + INR sB) * period k + period k) by lra.
  assert (counted : (eA + eB <= sA + sB)%nat).
  { destruct (le_lt_dec (eA + eB) (sA + sB)) as [? | more]; [assumption | exfalso].
    assert (INR (sA + sB) + 1 <= INR (eA + eB)) by (rewrite <- S_INR; apply le_INR; lia).
    rewrite !plus_INR in *.
    assert ((INR sA + INR sB + 1) * period k <= (INR eA + INR eB) * period k) by (apply Rmult_le_compat_r; lra). lra. }
  assert (sums : (S_p a i + S_q (negb a) j <= 2 + lA + lB)%nat) by (unfold eA, eB, sA, sB in *; lia).
  assert (sums' : INR (S_p a i) + INR (S_q (negb a) j) <= 2 + INR lA + INR lB).
  { change 2 with (INR 2). rewrite <- !plus_INR. apply le_INR. lia. }
  assert ((INR (S_p a i) + INR (S_q (negb a) j) - INR lA - INR lB) * period k <= 2 * period k) by (apply Rmult_le_compat_r; lra).
  (* The arrivals add up to less than nothing. *)
  destruct (its_arrivals _ _ _ _ _ _ _ _ P a). destruct (its_arrivals _ _ _ _ _ _ _ _ P (negb a)).
  destruct (its_arrivals _ _ _ _ _ _ _ _ Q a). destruct (its_arrivals _ _ _ _ _ _ _ _ Q (negb a)).
  lra.
Qed.

(* Even turns are for who gives way, odd ones for who comes first. The shield of vehicle x owns a turn by its own values. *)
Definition owns_by_order S_ L after by_ (x : bool) (i n : nat) :=
  if Nat.even (n / 2) then before S_ L after by_ (negb x) i else before S_ L after by_ x i.

(* Lemma 6. A count of the pair is the least of both. *)
Theorem orders_agree p sure_p ended_p S_p L_p o after by_ q sure_q ended_q S_q L_q o' after' by' pair_q x :
  knows p sure_p ended_p S_p L_p o after by_ -> knows q sure_q ended_q S_q L_q o' after' by' ->
  (forall j l, pair_q j = Some l -> forall y ly, L_q y j = Some ly -> (l <= ly)%nat) ->
  agree p q pair_q (owns_by_order S_p L_p after by_ x) (owns_by_order S_q L_q after' by' (negb x)).
Proof.
  intros P Q least_ i j n l order known no_end op oq. unfold owns_by_order in *.
  assert (ends : forall y ly, L_q y j = Some ly -> q (j - ly)%nat <= p i).
  { intros y ly e. specialize (least_ j l known y ly e). apply Rle_trans with (2 := no_end).
    apply (calls_ordered k q ok (its_grid _ _ _ _ _ _ _ _ Q)). lia. }
  destruct (Nat.even (n / 2)); eapply (orders_exclude p sure_p ended_p S_p L_p o after by_ q sure_q ended_q S_q L_q o' after' by');
    eauto.
Qed.

(** * Theorem 3 *)

Variables (T G : nat).
Hypothesis patient : (5 <= T)%nat.
Hypothesis graceful : (m + 2 <= G)%nat.

Section Two.
Variables (p q : nat -> R) (x : bool).
(* What the shields know of each vehicle, and what they count for the pair. P is the shield of vehicle x. *)
Variables (sure_p ended_p : bool -> nat -> Prop) (S_p : bool -> nat -> nat) (L_p : bool -> nat -> option nat).
Variables (sure_q ended_q : bool -> nat -> Prop) (S_q : bool -> nat -> nat) (L_q : bool -> nat -> option nat).
Variables (o o' : R) (after by_ after' by' : bool -> R).
Variables (rest_p end_p rest_q end_q : nat -> Prop) (both_S_p both_S_q : nat -> nat) (both_L_p both_L_q : nat -> option nat).
Variables (turn_p turn_q : nat -> option nat) (claim_p claim_q : nat -> Prop) (theta : R).
Hypothesis P : knows p sure_p ended_p S_p L_p o after by_.
Hypothesis Q : knows q sure_q ended_q S_q L_q o' after' by'.
Hypothesis pair_P : counts k v arrival from r m p rest_p end_p both_S_p both_L_p.
Hypothesis pair_Q : counts k v arrival from r m q rest_q end_q both_S_q both_L_q.
Hypothesis least_P : forall j l, both_L_p j = Some l -> forall y ly, L_p y j = Some ly -> (l <= ly)%nat.
Hypothesis least_Q : forall j l, both_L_q j = Some l -> forall y ly, L_q y j = Some ly -> (l <= ly)%nat.
Hypothesis arrivals_P : claims_by_arrival T both_L_p claim_p.
Hypothesis arrivals_Q : claims_by_arrival T both_L_q claim_q.

Definition claims_now (claim : nat -> Prop) (turn : nat -> option nat) i := claim i \/ turn i <> None.

(* Without a right of way. *)
Theorem never_both_equals :
  takes_turns T G both_S_p both_L_p (owns_by_order S_p L_p after by_ x) turn_p ->
  takes_turns T G both_S_q both_L_q (owns_by_order S_q L_q after' by' (negb x)) turn_q ->
  0 <= theta -> (forall i, claim_p i -> by_ x + theta <= after (negb x)) ->
  (forall j, claim_q j -> by' (negb x) + theta <= after' x) ->
  forall t i j, p i <= t < p (i + 1)%nat -> q j <= t < q (j + 1)%nat ->
  claims_now claim_p turn_p i -> ~ claims_now claim_q turn_q j.
Proof.
  intros tp tq th cp cq t i j np nq.
  apply (never_both k v arrival from r ok keeps m T G en patient graceful jitter_small) with (x := t) (p := p) (q := q) (1 := pair_P) (2 := pair_Q)
    (3 := tp) (4 := tq); auto.
  - apply (orders_agree p sure_p ended_p S_p L_p o after by_ q sure_q ended_q S_q L_q o' after' by'); auto.
  - pose proof (orders_agree q sure_q ended_q S_q L_q o' after' by' p sure_p ended_p S_p L_p o after by_ both_L_p (negb x)
      Q P least_P) as A. rewrite Bool.negb_involutive in A. exact A.
  - intros a b ca cb. specialize (cp a ca). specialize (cq b cb).
    destruct (its_arrivals _ _ _ _ _ _ _ _ P x). destruct (its_arrivals _ _ _ _ _ _ _ _ P (negb x)).
    destruct (its_arrivals _ _ _ _ _ _ _ _ Q x). destruct (its_arrivals _ _ _ _ _ _ _ _ Q (negb x)). lra.
Qed.

(* P has the right of way: Q gives way. *)
Theorem never_both_right_of_way :
  takes_turns T G both_S_p both_L_p (fun _ n => Nat.even (n / 2) = false) turn_p ->
  takes_turns T G both_S_q both_L_q (fun _ n => Nat.even (n / 2) = true) turn_q ->
  (forall i, claim_p i -> by_ x <= after (negb x) + theta) ->
  (forall j, claim_q j -> by' (negb x) + theta <= after' x) ->
  forall t i j, p i <= t < p (i + 1)%nat -> q j <= t < q (j + 1)%nat ->
  claims_now claim_p turn_p i -> ~ claims_now claim_q turn_q j.
Proof.
  intros tp tq cp cq t i j np nq.
  apply (never_both k v arrival from r ok keeps m T G en patient graceful jitter_small) with (x := t) (p := p) (q := q) (1 := pair_P) (2 := pair_Q)
    (3 := tp) (4 := tq); auto.
  - apply (right_of_way_agrees p q both_L_q false).
  - apply (right_of_way_agrees q p both_L_p true).
  - intros a b ca cb. specialize (cp a ca). specialize (cq b cb).
    destruct (its_arrivals _ _ _ _ _ _ _ _ P x). destruct (its_arrivals _ _ _ _ _ _ _ _ P (negb x)).
    destruct (its_arrivals _ _ _ _ _ _ _ _ Q x). destruct (its_arrivals _ _ _ _ _ _ _ _ Q (negb x)). lra.
Qed.

(* P has the right of way whoever arrives first: Q never claims but by turns. Whose turn it is, is settled by any order. *)
Theorem never_both_sides (gives_way : bool) :
  takes_turns T G both_S_p both_L_p (fun _ n => Nat.even (n / 2) = gives_way) turn_p ->
  takes_turns T G both_S_q both_L_q (fun _ n => Nat.even (n / 2) = negb gives_way) turn_q ->
  (forall j, ~ claim_q j) ->
  forall t i j, p i <= t < p (i + 1)%nat -> q j <= t < q (j + 1)%nat ->
  claims_now claim_p turn_p i -> ~ claims_now claim_q turn_q j.
Proof.
  intros tp tq none t i j np nq.
  apply (never_both k v arrival from r ok keeps m T G en patient graceful jitter_small) with (x := t) (p := p) (q := q) (1 := pair_P) (2 := pair_Q)
    (3 := tp) (4 := tq); auto.
  - apply (right_of_way_agrees p q both_L_q gives_way).
  - pose proof (right_of_way_agrees q p both_L_p (negb gives_way)) as A. rewrite Bool.negb_involutive in A. exact A.
Qed.
End Two.
End Order.
